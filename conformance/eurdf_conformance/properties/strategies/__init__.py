"""How random mechanisms are drawn: well-conditioned, of text that reads back exactly, and small once shrunk."""
