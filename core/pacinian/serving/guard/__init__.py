"""The guard process: the only one that opens the device. It lets frames through while they are permitted and fresh."""
