"""The core: forward kinematics, motion PCA and inverse kinematics; no command line, no spec, no printing."""
