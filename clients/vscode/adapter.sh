#!/bin/sh
# What VS Code starts as the debug adapter: the puckloop in PATH, or the one that PUCKLOOP names.
exec "${PUCKLOOP:-puckloop}" dap
