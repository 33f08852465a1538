#!/usr/bin/env python3
"""What include_direction.py must find, on a house of a few files."""
import pathlib
import tempfile
import unittest

import include_direction

ROOMS = """# room folders may include
base  src/base
model src/model base
study train/study model
programs train/programs study
# library
SQLite sqlite3.h base
"""


class IncludeDirection(unittest.TestCase):
    def faults(self, files):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name, text in files.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
            found = include_direction.faults(root, include_direction.House(ROOMS))
            return [fault for fault in found if "wrong folder?" not in fault]

    def test_what_is_allowed_passes(self):
        self.assertEqual(self.faults({
            "train/study/a.cpp": '#include "a.hpp"\n#include "elrom/base/x.hpp"\nnamespace elrom::study {\n',
            "train/study/a.hpp": "", "include/elrom/model/m.hpp": '#include "elrom/base/x.hpp"\n',
            "train/programs/p.cpp": '#include "elrom/study/s.hpp"\n'}), [])

    def one(self, files, words):
        found = self.faults(files)
        self.assertEqual(len(found), 1, found)
        self.assertIn(words, found[0])

    def test_against_the_direction(self):
        self.one({"src/model/a.cpp": '#include "elrom/study/s.hpp"\n'}, "model includes study")

    def test_from_a_public_header(self):
        self.one({"include/elrom/base/a.hpp": '#include "elrom/model/s.hpp"\n'}, "base includes model")

    def test_unknown_folder(self):
        self.one({"train/attic/a.cpp": "\n"}, "no room")

    def test_unknown_room(self):
        self.one({"src/model/a.cpp": '#include "elrom/attic/s.hpp"\n'}, "'attic'")

    def test_private_header_of_another_room(self):
        self.one({"train/study/a.cpp": '#include "../../src/model/inner.hpp"\n', "src/model/inner.hpp": ""}, "reaches into")
        self.one({"train/study/a.cpp": '#include "inner.hpp"\n', "src/model/inner.hpp": ""}, "outside its folder")

    def test_private_header_in_a_public_one(self):
        self.one({"include/elrom/model/a.hpp": '#include "b.hpp"\n', "include/elrom/model/b.hpp": ""}, "outside its folder")

    def test_library_of_one_room(self):
        self.one({"src/model/a.cpp": "#include <sqlite3.h>\n"}, "SQLite belongs into base")

    def test_namespace_of_another_room(self):
        self.one({"src/model/a.cpp": "namespace elrom::study {\n"}, "in the room model")


if __name__ == "__main__":
    unittest.main()
