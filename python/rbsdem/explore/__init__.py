"""The page on which one draws a column and sees its loops, and reports made of the same parts.

`state` reads what the page sends, `compute` answers it by the functions that everybody calls,
`texts` writes and opens files, `server` talks to the browser, `report` puts the answers in a file.
`parts` has the files of the page; the gallery of `rbsdem.peer` is made of them too.
"""
