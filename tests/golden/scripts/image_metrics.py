#!/usr/bin/env python3
"""Golden values for image difference metrics on formula-made images.

Builds 64x48 (W x H) sRGB-encoded float64 images from closed formulas, compares
each test image with `base`, and writes image_metrics.csv (case,metric,value).

  psnr             skimage, all pixels and channels, data range 1, dB
  ssim             skimage, Gaussian window sigma 1.5 (11 taps), population
                   covariance, data range 1, mean over channels; the outer 5
                   pixels are cropped before the mean
  ssim_map_*       full (uncropped) SSIM map, mean over channels
  flip             LDR-FLIP mean, default viewing conditions (ppd ~ 67.02)
  flip_map_*       LDR-FLIP error map
  delta_e_itp      mean ITU-R BT.2124 delta E ITP; sRGB EOTF, 1.0 = 203 cd/m2,
                   BT.709 -> BT.2020 by the rounded BT.2087 matrix, PQ ICtCp
  delta_e_itp_*    the same, per pixel

Map keys rRR_cCC are 0-based (row, column). FLIP takes and returns float32 (the
images are rounded to it first, its values carry about 7 digits); the rest is
float64.

Recorded with Python 3.11.7, numpy 2.4.6, scipy 1.17.1, scikit-image 0.26.0,
flip-evaluator 1.7, colour-science 0.4.7.
"""

import csv
from pathlib import Path

import colour
import flip_evaluator
import numpy as np
from skimage.metrics import peak_signal_noise_ratio, structural_similarity

WIDTH, HEIGHT = 64, 48
WHITE_CD_M2 = 203.0

Y, X, C = np.meshgrid(np.arange(HEIGHT, dtype=np.float64),
                      np.arange(WIDTH, dtype=np.float64),
                      np.arange(3, dtype=np.float64), indexing="ij")

# ITU-R BT.2087-0, linear BT.709 -> linear BT.2020, as printed (4 decimals).
BT709_TO_BT2020 = np.array([[0.6274, 0.3293, 0.0433],
                            [0.0691, 0.9195, 0.0114],
                            [0.0164, 0.0880, 0.8956]])


def base(dx=0.0, dy=0.0):
    x, y = X + dx, Y + dy
    return np.clip(0.5 + 0.35 * np.sin(0.21 * x + 0.13 * y + C)
                   * np.cos(0.17 * y - 0.07 * x * C), 0.0, 1.0)


def cases():
    b = base()
    spot = np.exp(-((X - 40.0) ** 2 + (Y - 20.0) ** 2) / 18.0)
    return {
        "identical": b.copy(),
        "noise": np.clip(b + 0.04 * np.sin(12.9898 * X + 78.233 * Y + 37.719 * C), 0, 1),
        "shift": base(dx=2.0),
        "brighter": np.clip(1.1 * b + 0.02, 0, 1),
        "blur": sum(base(dx, dy) for dy in (-1, 0, 1) for dx in (-1, 0, 1)) / 9.0,
        "highlight": np.clip(b + 0.5 * spot, 0, 1),
    }


def psnr(ref, test):
    if np.array_equal(ref, test):
        return float("inf")
    return peak_signal_noise_ratio(ref, test, data_range=1.0)


def ssim(ref, test):
    mean, full = structural_similarity(
        ref, test, gaussian_weights=True, sigma=1.5, use_sample_covariance=False,
        data_range=1.0, channel_axis=2, full=True)
    return mean, full.mean(axis=2)


def flip(ref, test):
    error, mean, parameters = flip_evaluator.evaluate(
        ref.astype(np.float32), test.astype(np.float32), "LDR",
        inputsRGB=True, applyMagma=False, computeMeanError=True)
    return mean, np.squeeze(error), parameters


def srgb_to_linear_bt2020(srgb):
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    return WHITE_CD_M2 * linear @ BT709_TO_BT2020.T


def ictcp(srgb):
    # L_p = 10000 (the default) makes the input absolute cd/m2.
    return colour.RGB_to_ICtCp(srgb_to_linear_bt2020(srgb),
                               method="ITU-R BT.2100-2 PQ", L_p=10000)


def delta_e_itp(ref, test):
    return colour.difference.delta_E_ITP(ictcp(ref), ictcp(test))


def rows():
    ref = base()
    for case, test in cases().items():
        yield case, "psnr", psnr(ref, test)
        mean, ssim_map = ssim(ref, test)
        yield case, "ssim", mean
        yield case, "ssim_map_r12_c20", ssim_map[12, 20]
        mean, flip_map, _ = flip(ref, test)
        yield case, "flip", mean
        yield case, "flip_map_r12_c20", flip_map[12, 20]
        yield case, "flip_map_r20_c40", flip_map[20, 40]
        error = delta_e_itp(ref, test)
        yield case, "delta_e_itp", error.mean()
        yield case, "delta_e_itp_r12_c20", error[12, 20]


if __name__ == "__main__":
    with open(Path(__file__).with_name("image_metrics.csv"), "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["case", "metric", "value"])
        for case, metric, value in rows():
            out.writerow([case, metric, repr(float(value))])
