# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""What VTK's objects say."""


class Messages:
    """Collects the warnings and errors of objects, and of the executives of algorithms, instead of printing them."""

    def __init__(self, *objects):
        self.warnings, self.errors = [], []
        executives = [item.GetExecutive() for item in objects if item.IsA("vtkAlgorithm")]
        for event, into in (("WarningEvent", self.warnings), ("ErrorEvent", self.errors)):
            def observer(caller, name, text, into=into):
                into.append(text)
            observer.CallDataType = "string0"
            for item in (*objects, *executives):
                item.AddObserver(event, observer)
