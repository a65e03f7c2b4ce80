"""The preview page: bodies packed into one HTML file that plays them without a network or a library."""
