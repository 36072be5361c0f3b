"""What the page about Python shows runs as it stands."""
import pathlib
import re

PAGE = pathlib.Path(__file__).parents[2] / "tools/docs/python.md"


def test_the_examples_of_the_page(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out").mkdir()
    blocks = re.findall(r"<!-- run by test/python/test_page.py -->\n```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    assert len(blocks) == 3
    exec("\n".join(blocks), {})
    assert (tmp_path / "out/optimize/report.html").exists() and (tmp_path / "out/atlas.bin").exists()
