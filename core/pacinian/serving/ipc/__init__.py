"""Inter-process basics: how the server's processes start, share memory, keep time, log and authenticate each other."""
