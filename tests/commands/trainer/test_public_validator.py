# SPDX-License-Identifier: Apache-2.0
"""Statements for learning record stores before a public judge: Learning Locker's validator (MIT), which npm brings."""
import shutil
import subprocess
import unittest

from trainer_case import TRAIN, TrainerCase

JUDGE = """
const validate = require('@learninglocker/xapi-validation').default;
for (const line of require('fs').readFileSync(0, 'utf8').trim().split('\\n')) {
    const statement = JSON.parse(line), bad = {...statement, verb: {id: 'passed'}};
    console.log(validate(statement).length, validate(bad).length > 0);
}"""


@unittest.skipUnless(shutil.which("npm"), "PALPATE: npm is missing, which brings a public validator of statements")
class PublicValidator(TrainerCase):
    def test_takes_what_an_attempt_leaves(self):
        try:
            fetched = subprocess.run(["npm", "install", "--silent", "--prefix", self.folder / "npm", "@learninglocker/xapi-validation@3.0.0"],
                                     capture_output=True, text=True, timeout=120)
        except subprocess.TimeoutExpired:
            self.skipTest("PALPATE: npm does not answer")
        if fetched.returncode != 0:
            self.skipTest("PALPATE: npm cannot fetch the validator of statements")
        exercise, hand = self.folder / "mark.toml", self.folder / "hand.txt"
        exercise.write_text('schema = 1\n[[exercise]]\nname = "mark"\ntask = "touch"\nhold_s = 0.2\nmost_force_n = 1\nplaces_mm = [[10, 10, 20]]\n')
        hand.write_text("0 10 10 26\n1 10 10 20\n5 10 10 20\n")
        subprocess.run([TRAIN, self.asset, "--exercises", exercise, "--exercise", "mark", "--script", hand, "--seconds", "5", "--attempts", self.folder,
                        "--quiet"], env=self.server.environment, check=True, capture_output=True, timeout=90)
        statements = (self.folder / "guest" / "statements.jsonl").read_text()
        self.assertIn("verbs/passed", statements)
        judged = subprocess.run(["node", "-e", JUDGE], cwd=self.folder / "npm", input=statements, capture_output=True, text=True, timeout=60)
        self.assertEqual(judged.returncode, 0, judged.stderr)
        self.assertEqual(judged.stdout.splitlines(), ["0 true"] * len(statements.splitlines()))


if __name__ == "__main__":
    unittest.main()
