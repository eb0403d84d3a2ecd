"""The palette of a picture: few colours, with transparency, that replace all that it has."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

_ROUNDS = 8  # of averaging; later ones change no colour that is seen

Bytes = npt.NDArray[np.uint8]


def with_palette(image: Bytes, most: int = 256) -> tuple[Bytes, Bytes]:
    """The palette of a picture, and the number of each pixel in it.

    Pillow's fast octree gives the first palette; each colour then becomes the average of the pixels nearest to it
    (Lloyd's algorithm). Distances are those of colours multiplied by alpha, so that transparent ones are alike.

    Args:
        image: Pixels (height, width, 4): red, green, blue, alpha.
        most: How many colours the palette has at most, at most 256.

    Returns:
        The colours (n, 4), and the indices (height, width).
    """
    from PIL import Image as Pillow

    picture = Pillow.fromarray(image)
    first = picture.quantize(most, method=Pillow.Quantize.FASTOCTREE, dither=Pillow.Dither.NONE)
    palette = _colors(np.unique(_premultiplied(first.convert("RGBA")))).astype(float)
    found, where, counts = np.unique(_premultiplied(picture), return_inverse=True, return_counts=True)
    colors = _colors(found)
    nearest = _nearest(colors, palette)
    for _ in range(_ROUNDS):
        weight = np.bincount(nearest, counts)
        sums = [np.bincount(nearest, counts * channel) for channel in colors.T]
        palette = (np.array(sums) / np.maximum(weight, 1)).T[weight > 0]
        nearest = _nearest(colors, palette)
    rounded = np.rint(palette).astype(np.uint8)
    straight = Pillow.frombuffer("RGBa", (len(rounded), 1), rounded).convert("RGBA")
    return np.asarray(straight)[0], nearest[where].reshape(image.shape[:2]).astype(np.uint8)


def _premultiplied(picture: Any) -> npt.NDArray[np.uint32]:
    """The colours (n,) of the pixels times alpha, each as one number."""
    return np.asarray(picture.convert("RGBa")).view(np.uint32).ravel()


def _colors(numbers: npt.NDArray[np.uint32]) -> Bytes:
    """The colours (n, 4) of such numbers."""
    return numbers.view(np.uint8).reshape(-1, 4)


def _nearest(colors: Bytes, palette: npt.NDArray[np.float64]) -> npt.NDArray[np.intp]:
    """For each colour the number of the nearest one of the palette."""
    nearest: npt.NDArray[np.intp] = ((palette**2).sum(axis=1) - 2.0 * colors @ palette.T).argmin(axis=1)
    return nearest
