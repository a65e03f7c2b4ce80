"""The example specs of the documentation's contract."""

NORMALIZE = """\
schema: motionedit/normalize/v1
frames: mean                 # default; the mean duration, eq. (13)-(14); or an integer such as 132
frame_rate: 25               # Hz; default: the clips' own rate (an error where they differ)
align: {heading: true, position: true, at: first}     # default
rest_pose: drop              # default; a T-pose in front of the take: drop | keep
events:                      # none: durations only
  hit:
    target: mean             # default; mean key frame, eq. (14); or a time of the normalized clip
    frames: {swing01: 88, swing02: 93}      # by clip, 0-based, in the input
    detect:                  # for clips not listed
      effector: {joint: Club, offset: [0, -92, 0]}
      minimum_of: distance   # height | speed | distance;  or  maximum_of:
      to: [0, 0, 60]         # for distance
      between: [40%, 90%]    # or  after: another event
"""

FIT_PCA = """\
schema: motionedit/fit-pca/v1
components: 9
rotation: centred
root_weight: 1
exclude_joints: [LeftThumb, RightThumb]
"""

EDIT_PC = """\
schema: motionedit/edit-pc/v1
components: 8                # or explained_variance: 0.95; default: all in the model
goals:
  - name: ball
    at: hit
    effector: {joint: Club, offset: [0, -92, 0]}
    position: [12.0, 2.5, 61.0]     # or  shift: [-8, 0, 0]; and/or  orientation: {...}
    frame: world             # default
    axes: [x, y, z]          # default all
    weight: 1.0              # default
    priority: 1              # default; larger = more important; equal = weighted together
    tolerance: 0.1           # default 1 mm, 0.1 degree (at leg length 0.85 m)
solver: {method: map}            # default
residual_share: auto         # default
feet: keep                   # default: planted feet stand where the input's stand | move | off
plausibility: 3              # default
coefficients: constant       # default | per_goal
residual: keep               # default | drop (the paper's eq. 3 alone)
timing: original             # default | normalized
"""

EDIT_PC_DAMPED = """\
schema: motionedit/edit-pc/v1
unit: cm
explained_variance: 0.95
goals:
  - {at: hit, effector: {joint: Club, offset: [0, -92, 0]}, shift: [-8, 0, 0]}
solver: {method: damped, damping: 10, damping_unit: cm, max_iterations: 1500, tolerance: 1.0}
"""

EDIT_PRIORITIZED = """\
schema: motionedit/edit-prioritized/v1
unit: cm
defaults: {ease_in: 0.8s, ease_out: 0.8s, weight: 1.0, recruit: all}       # these are the defaults
constraints:
  - name: right-toe-steps
    type: position                 # a shape constraint S(T(t)), section 4.2
    effector: RightToeBase
    priority: 10                   # larger = more important; only the order matters
    points:
      - {hold: [20, 41], position: [14, 17, 60]}          # stands still; tension 1 is implied
      - {at: 58, shift: [0, 22, 0], tension: 0, continuity: 0, bias: 0.3}
      - {hold: [76, 99], shift: [0, 34, 0]}
    tolerance: 0.5
  - name: left-foot-as-captured
    type: position
    effector: [LeftFoot, LeftToeBase]
    priority: 10                   # no points: rides the input's own trajectory, the whole clip
  - name: hand-higher
    type: position
    effector: LeftHand
    priority: 4
    points: [{during: [60, 90], shift: [0, 15, 0]}]       # rides: the input's trajectory + shift
  - name: foot-planted
    type: pose                     # position and orientation together: a footplant that cannot roll
    effector: LeftFoot
    priority: 11
    points: [{hold: [30, 52]}]     # where it is, and as it is turned, in the input at frame 30
  - name: balance
    type: com                      # section 4.3
    priority: 5
    support: [LeftFoot, LeftToeBase, RightFoot, RightToeBase]
    relative_to: support           # default
    axes: [x, z]
    points: [{at: 20}, {at: 60, shift: [0, 0, 3]}, {at: 99}]     # optional displacement map
  - name: elbow-near-torso
    type: position
    effector: RightForeArm
    relative_to: Spine1            # positions are in that joint's frame
    recruit: {up_to: RightShoulder}     # all | {up_to: joint} | {levels: 3} | {joints: [...]}
    priority: 2
    points: [{hold: [20, 99], position: [-28, 4, 9]}]
  - name: forearm-level
    type: orientation
    effector: RightForeArm
    priority: 2
    weight: 0.5
    points: [{hold: [20, 99], orientation: {euler: [0, 0, -35], order: ZXY}}]
  - name: eyes
    type: aim
    effector: Head
    axis: [0, 0, 1]
    recruit: {joints: [Head, Neck]}
    priority: 1
    points: [{hold: [20, 99], position: [100, 160, 200]}]
  - name: keep-the-head
    type: posture
    joints: [Neck, Head]
    priority: 1
  - name: floor
    type: floor                  # one-sided: nothing of these goes below
    effector: feet               # default: feet and toes found in the skeleton; or `all`, or a list
    height: 0
    priority: 9
  - name: grip
    type: distance               # between two points of the body, or of body and joint
    effector: LeftHand
    to: RightHand                # an effector
    priority: 5
    points: [{hold: [20, 90], distance: 32}]      # none: as in the input; {at_least: 20} or {at_most: 40} instead
masses: {Spine: 12.5}
hinges: auto
attraction: 1.0
smoothing: {method: passes, passes: 3, sigma: 0.062s}
curve: time
solver: {max_iterations: 40}
recruiting_rule: expand
"""

EXAMPLES = {
    "normalize": ("normalize", NORMALIZE),
    "fit-pca": ("fit-pca", FIT_PCA),
    "edit-pc": ("edit-pc", EDIT_PC),
    "edit-pc damped": ("edit-pc", EDIT_PC_DAMPED),
    "edit-prioritized": ("edit-prioritized", EDIT_PRIORITIZED),
}
