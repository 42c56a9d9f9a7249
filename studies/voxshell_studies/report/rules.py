"""Names of the two contact rules in rows and figures."""

RULE_NAMES = {"published": "published rule", "voxshell": "our rule"}
