"""Commands that print the project's numbers."""
