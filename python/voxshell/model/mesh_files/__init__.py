"""Files of meshes: opened, and measured against budgets before any library reads them."""
