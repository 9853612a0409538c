"""Other forms of a law: a simpler one that says as much, its curve where it is other than ours, a likelier relative."""
