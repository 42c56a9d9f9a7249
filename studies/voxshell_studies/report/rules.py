"""What rows and figures call the two rules of which points are contacts."""

RULE_NAMES = {"published": "published rule", "voxshell": "our rule"}
