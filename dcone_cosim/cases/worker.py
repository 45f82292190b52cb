"""The child of `workers`: does what it is sent, one thing after the other, and answers.

Its first two streams carry pickles both ways (see `child`): what is sent is a function of ours and what to give it, so
that nothing but this program writes there.
"""

from __future__ import annotations

import os
import pickle
import signal
import traceback
from contextlib import suppress

from dcone_cosim.child import end_with_parent, own_streams


def main() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    calls, answers = own_streams()
    end_with_parent()
    with os.fdopen(calls, "rb") as asked, os.fdopen(answers, "wb") as told, suppress(EOFError, BrokenPipeError):
        while True:
            work, argument = pickle.load(asked)
            try:
                answer = (True, work(argument))
            except Exception:
                answer = (False, traceback.format_exc())
            pickle.dump(answer, told)
            told.flush()


if __name__ == "__main__":
    main()
