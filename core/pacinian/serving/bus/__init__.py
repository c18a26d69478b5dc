"""The bus process: it takes clients' commands, keeps their objects, and tells the renderer what is new."""
