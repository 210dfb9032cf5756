"""The result that users get, its files, its error, and the cases of the executable."""
