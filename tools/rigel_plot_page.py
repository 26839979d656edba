"""The files that rigel_plot.py writes: figures (PNG and SVG) and one page with all of them."""
import base64
import html
import io
import os
import re

from rigel_files import Bad, write_whole
from rigel_plot_style import Image, plt

PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Rigel: experiments</title>
<style>
body {{ font: 15px/1.45 sans-serif; max-width: 1150px; margin: 2em auto; padding: 0 1em; }}
img {{ max-width: 100%; }}
table {{ border-collapse: collapse; }}
td, th {{ border: 1px solid #bbb; padding: .3em .5em; text-align: left; vertical-align: top; }}
pre {{ font-size: 12px; line-height: 1.25; overflow-x: auto; background: #f6f6f6; padding: .7em; }}
.confirmed {{ background: #d9efe6; }} .partly {{ background: #fdf1cf; }}
.not-confirmed {{ background: #f8dccb; }} .too-few-pairs {{ background: #eeeeee; }}
</style></head><body>
<h1>Rigel: experiments</h1>
{body}
</body></html>
"""


def save(figure, directory, name, dpi):
    """Writes both files; returns their paths, the SVG's last."""
    paths = [os.path.join(directory, f"{name}.{kind}") for kind in ("png", "svg")]
    png, small, svg = io.BytesIO(), io.BytesIO(), io.StringIO()
    figure.savefig(png, format="png", dpi=dpi, metadata={"Software": None})
    figure.savefig(svg, format="svg", metadata={"Date": None, "Creator": "rigel_plot.py"})
    plt.close(figure)
    # 128 colours are enough for lines and letters; a third of the size.
    with Image.open(png) as image:
        image.convert("RGB").quantize(128).save(small, format="png", optimize=True)
    text = svg.getvalue()
    # A hundredth of a point is fine enough; half the size.
    text = re.sub(r"(\d\.\d\d)\d+", r"\1", text)
    text = re.sub(r"(<use [^>]*); stroke-linejoin: miter", r"\1", text)
    text = re.sub(r"\n +", "\n", text)
    write_whole(paths[0], small.getvalue())
    write_whole(paths[1], text.encode("utf-8"))
    return paths


def claims_html(report):
    lines = ["<h2>Claims</h2><table><tr><th>of</th><th>experiment</th><th>claim</th>"
             "<th>verdict</th><th>figures</th><th>where not</th></tr>"]
    for claim in report["claims"]:
        cells = [claim[k] for k in ("of", "experiment", "claim", "verdict", "figures", "where_not")]
        kind = claim["verdict"].replace(" ", "-")
        lines.append(f'<tr class="{html.escape(kind)}">' +
                     "".join(f"<td>{html.escape(c)}</td>" for c in cells) + "</tr>")
    return "\n".join(lines + ["</table>"])


def image_html(svg_path, name):
    # As an image, so that names within one figure do not meet those of another.
    with open(svg_path, "rb") as file:
        data = base64.b64encode(file.read()).decode("ascii")
    return f'<img alt="{html.escape(name)}" src="data:image/svg+xml;base64,{data}">'


class Page:
    """The figures of a run. Their files are written one by one, then the page if asked for."""

    def __init__(self, directory, dpi):
        self.directory, self.dpi = directory, dpi
        self.claims, self.sections = [], []
        self.written = 0

    def add_claims(self, report):
        self.claims.append(claims_html(report))

    def add(self, figures, title, table_path=None):
        part = [f"<h2>{html.escape(title)}</h2>"]
        for name, figure in figures:
            try:
                paths = save(figure, self.directory, name, self.dpi)
            except OSError as error:
                raise Bad(f"{self.directory}: cannot be written: {error}") from error
            self.written += 1
            part.append(image_html(paths[1], name))
        if table_path and os.path.exists(table_path):
            with open(table_path, encoding="utf-8") as file:
                part.append("<pre>" + html.escape(file.read()) + "</pre>")
        self.sections.append("\n".join(part))

    def write(self, path):
        text = PAGE.format(body="\n".join(self.claims + self.sections))
        try:
            write_whole(path, text.encode("utf-8"))
        except OSError as error:
            raise Bad(f"{path}: cannot be written: {error}") from error
