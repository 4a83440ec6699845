"""`puckloop mcp`: a server of the Model Context Protocol on standard input and output (docs/mcp.md).

folders.py decides what files may be named, runs.py keeps the runs, tools.py has what can be called, server.py speaks
JSON-RPC.
"""
