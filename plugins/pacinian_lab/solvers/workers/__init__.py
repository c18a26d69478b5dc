"""What each contestant does in its own process; loaded by file, so none imports its neighbours."""
