  // viser begins with lights of its own and the picture of a room, and a replay returns to them in each round: it loads
  // that picture and blurs it, which takes seconds without a graphics card. Light of our own needs neither.
  (() => {
    function findViewer() {
      const root = document.getElementById("root");
      const key = root && Object.keys(root).find((name) => name.startsWith("__reactContainer$"));
      const parts = key ? [root[key].stateNode.current] : [];
      while (parts.length > 0) {
        const { child, sibling, memoizedProps } = parts.pop();
        const value = memoizedProps && memoizedProps.value;
        if (value && value.useEnvironment && value.useDevSettings) return value;
        parts.push(...[sibling, child].filter(Boolean));
      }
      return null;
    }

    function keepLights(viewer) {
      const noRoom = { hdri: null, hdri_data: null }; // viser before 1.1 has the first of these
      viewer.useEnvironment.set({ enableDefaultLights: false, environmentMap: noRoom });
      viewer.useEnvironment.set = () => {};
    }

    // viser draws slow pages at three quarters of the resolution, which hardly saves time, and leaves pictures that
    // stand as they are.
    let sharpness = 0;
    function keepSharp(viewer) {
      const wanted = Math.min(Math.max(window.devicePixelRatio, 1), 2);
      if (wanted !== sharpness) viewer.useDevSettings.set({ fixedDpr: wanted });
      sharpness = wanted;
    }

    // The edges of shadows are as sharp as a texel until they are told to be soft. Within the radius of that, surfaces
    // that lean would shade themselves, in dots.
    function softenShadows(player) {
      player.scene.traverse((object) => {
        if (!object.isDirectionalLight || !object.castShadow || object.shadow.radius === 5) return;
        object.shadow.radius = 5;
        object.shadow.normalBias = 0.06;
        player.requestRender();
      });
    }

    let viewer = null, looked = false;
    function everyPicture() {
      const player = window.__viserMutable;
      if (player && !looked) {
        looked = true; // where it finds none, the page works on without
        viewer = findViewer();
        if (viewer) keepLights(viewer);
      }
      if (viewer) keepSharp(viewer);
      if (player && player.scene) softenShadows(player);
      requestAnimationFrame(everyPicture);
    }
    requestAnimationFrame(everyPicture);
  })();
