"""Reports: the only place where sentences, figures and pages are made."""
