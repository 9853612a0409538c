"""The five source papers: every number beside what the program computes."""
