"""The bus process: it takes clients' commands, stores their objects, and sends the changes to the renderer."""
