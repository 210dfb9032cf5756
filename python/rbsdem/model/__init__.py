"""Drawing, springs, column: data and checks."""
