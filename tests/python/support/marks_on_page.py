"""Where a page draws bodies and contacts: read from its scene and projected by its camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from playwright.sync_api import Page

_READ = """(names) => {
  const player = window.__viserMutable, canvas = document.querySelector("canvas[data-engine]");
  const scene = player.nodeRefFromName[""];
  player.camera.updateMatrixWorld();
  scene.updateWorldMatrix(true, true);
  const found = {
    world: scene.matrixWorld.elements, view: player.camera.matrixWorldInverse.elements,
    projection: player.camera.projectionMatrix.elements,
    size: [canvas.clientWidth, canvas.clientHeight], places: {},
  };
  for (const name of names) {
    const node = player.nodeRefFromName[name];
    let batch = null;
    if (node) node.traverse((object) => { if (object.isInstancedMesh2) batch = object; });
    let places = [];
    if (batch && node.visible) {
      const matrices = batch.matricesTexture.image.data;
      for (let i = 0; i < batch.instancesCount; i++) {
        const place = batch.position.clone().fromArray(matrices, 16 * i + 12);
        places.push(place.applyMatrix4(batch.matrixWorld).toArray());
      }
    } else if (node && !batch) {
      places.push(node.matrixWorld.elements.slice(12, 15));
    }
    found.places[name] = places;
  }
  return JSON.stringify(found);
}"""


@dataclass(frozen=True)
class Drawn:
    """Nodes of a page at one instant.

    Args:
        places: (k, 3) of each node's instances, or (1, 3) of a single one, in three.js' world.
        world: (4, 4) that takes display units to three.js' world.
        clip: (4, 4) that takes three.js' world to clip space.
        size: Width and height of the picture, pixels.
    """

    places: dict[str, NDArray[np.float64]]
    world: NDArray[np.float64]
    clip: NDArray[np.float64]
    size: NDArray[np.float64]

    def place(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """(k, 3) in three.js' world, of (k, 3) in display units."""
        return points @ self.world[:3, :3].T + self.world[:3, 3]

    def project(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """(k, 2) pixels from the top left, of (k, 3) in three.js' world."""
        clipped = places @ self.clip[:, :3].T + self.clip[:, 3]
        return 0.5 * (clipped[:, :2] / clipped[:, 3:] * (1.0, -1.0) + 1.0) * self.size

    def pixels_off(self, name: str, points: NDArray[np.float64]) -> float:
        """The largest distance, pixels, of a node's instances from (k, 3) in display units."""
        drawn = self.places[name]
        if drawn.shape != points.shape:
            return np.inf
        apart = self.project(drawn) - self.project(self.place(points))
        return float(np.linalg.norm(apart, axis=1).max(initial=0.0))


def read_drawn(page: Page, *names: str) -> Drawn:
    """What the page draws now, read in one go, so that all nodes are of one instant."""
    import json

    found = json.loads(page.evaluate(_READ, list(names)))
    view, projection = (np.array(found[key]).reshape(4, 4).T for key in ("view", "projection"))
    return Drawn(
        {name: np.array(rows).reshape(-1, 3) for name, rows in found["places"].items()},
        np.array(found["world"]).reshape(4, 4).T,
        projection @ view,
        np.array(found["size"], dtype=np.float64),
    )
