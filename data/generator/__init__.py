"""Makes the clips that ship with motionedit: golf swings, a walk and a kick, from curves of posture."""
