"""The version, which is known without git, and without the rest of the package."""

__version__ = "0.1.0"
