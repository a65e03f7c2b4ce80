"""Many edits of many clips, measured from outside: a reader and kinematics of their own, joints named by hand."""
