#!/bin/sh
# The demonstration's data into $1: the fibres from the wheel of dipy 1.12.1 (a zip; nothing of it is
# installed), and links to the MRI brains of Debian's mricron-data. Does nothing where they are there.
set -eu
into=$1
python=$(dpkg -L python3-minimal | grep 'bin/python3$' | head -n 1)
mkdir -p "$into"
for brain in ch2bet ch2better; do
  file=$(dpkg -L mricron-data | grep "/$brain.nii.gz\$")
  ln -sfn "$file" "$into/$brain.nii.gz"
done
[ -s "$into/tracks300.trk" ] && [ -s "$into/minimal_bundles.zip" ] && exit 0
wheel=$into/wheel
rm -rf "$wheel"
"$python" -m pip download -q --no-deps --only-binary :all: -d "$wheel" 'dipy==1.12.1' ||
  { echo "cannot download dipy 1.12.1 from the Python package index"; exit 1; }
"$python" - "$wheel" "$into" <<'PY'
import glob, os, sys, zipfile

wheel, into = sys.argv[1:]
with zipfile.ZipFile(glob.glob(os.path.join(wheel, "dipy-*.whl"))[0]) as archive:
    for name in ("tracks300.trk", "minimal_bundles.zip"):
        with archive.open("dipy/data/files/" + name) as source, open(os.path.join(into, name), "wb") as out:
            out.write(source.read())
PY
rm -rf "$wheel"
