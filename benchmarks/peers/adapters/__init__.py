"""One file a library; each lists its peers in `PEERS`."""
