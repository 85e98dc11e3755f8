# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""What ParaView says, kept from being printed."""
import sys

from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow

# pvbatch prints through the output window too
sys.stdout, sys.stderr = sys.__stdout__, sys.__stderr__
said = vtkStringOutputWindow()
vtkOutputWindow.SetInstance(said)


def messages():
    """What errors and warnings have been written since the last call."""
    text = said.GetOutput()
    messages.seen, start = len(text), getattr(messages, "seen", 0)
    return text[start:]
