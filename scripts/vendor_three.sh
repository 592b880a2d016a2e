#!/bin/sh
# Bundle three.js into src/aeroservo/report/assets/three.min.js. Needs npm (for its registry) and node; run it by hand
# when the version changes, look at the report afterwards, and write the versions into assets/SOURCE.md.
set -eu
three=0.187.0
esbuild=0.28.2
root=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm pack --silent "three@$three" "@esbuild/linux-x64@$esbuild"
mkdir -p node_modules/three esbuild
tar xf "three-$three.tgz" -C node_modules/three --strip-components=1
tar xf "esbuild-linux-x64-$esbuild.tgz" -C esbuild --strip-components=1
cat > entry.js <<'END'
export {
  AmbientLight, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, Group, Line, LineBasicMaterial,
  LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera, Scene, Vector3, WebGLRenderer,
  HemisphereLight, GridHelper, Box3, Sphere, DynamicDrawUsage, PlaneGeometry, ArrowHelper
} from "three";
export { OrbitControls } from "three/addons/controls/OrbitControls.js";
END
./esbuild/bin/esbuild entry.js --bundle --minify --format=iife --global-name=THREE --legal-comments=none \
  --target=es2020 --outfile=three.min.js
cp three.min.js "$root/src/aeroservo/report/assets/three.min.js"
cp node_modules/three/LICENSE "$root/src/aeroservo/report/assets/three.LICENSE.txt"
