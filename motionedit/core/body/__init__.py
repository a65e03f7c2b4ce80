"""What is read off a body: its limbs, where its mass is, which way is up, when its feet stand."""
