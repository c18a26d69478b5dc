"""How the server's processes start, share memory, keep time, log and let each other in."""
