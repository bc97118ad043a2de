"""One file a library; `roster.py` names its classes."""
