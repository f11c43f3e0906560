#!/usr/bin/env bash
# Ten materials, six methods, about 34 kB each: the table in docs/separable.md.
# usage: docs/compare_methods.sh DATA OUT        (DATA: the folder of measured materials)
set -euo pipefail
data=$1 out=$2
mkdir -p "$out/reference"
for name in gold-paint colonial-maple-223 pink-felt blue-acrylic chrome-steel black-fabric; do
  brdf convert "$data/nbrdf/merl_dev.npz:$name" "$out/reference/$name.binary"
done
cp "$data"/merl_layout_derived/*.binary "$out/reference/"
cp "$data"/rgl/c{m_military_green,c_iris_purple_gem}_rgb.bsdf "$out/reference/"
half="--space half-difference --isotropic --joint-rgb --rank 4 --resolution 26"
for file in "$out"/reference/*; do
  name=$(basename "$file"); name=${name%.*}
  brdf factor "$file" -o "$out/search/$name" --method search
  brdf factor "$file" -o "$out/mccool/$name" --method mccool --texture-size 38
  brdf factor "$file" -o "$out/svd-wi-wo/$name" --method svd --joint-rgb --rank 4 --resolution 23
  brdf factor "$file" -o "$out/svd-h-d/$name" --method svd $half
  brdf factor "$file" -o "$out/log-svd-h-d/$name" --method log-svd $half
  brdf factor "$file" -o "$out/nmf-h-d/$name" --method nmf $half
done
cd "$out"
brdf compare reference search mccool svd-wi-wo svd-h-d log-svd-h-d nmf-h-d --metrics all --json > methods.json
