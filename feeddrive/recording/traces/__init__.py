"""Traces before they are recordings: channels named, judged, and brought onto one grid."""
