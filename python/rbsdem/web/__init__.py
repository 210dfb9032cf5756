"""The page on which one draws a column and sees its loops, and reports made of the same parts."""
