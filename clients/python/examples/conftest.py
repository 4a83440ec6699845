pytest_plugins = ["puckloop.pytest_plugin"]
