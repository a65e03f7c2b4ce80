"""Whether clips, and a spec for them, are fit for use."""
