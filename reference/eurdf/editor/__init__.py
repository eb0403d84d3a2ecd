"""The language server, ``eurdf server``: what an editor shows of the files of robots that are open in it."""
