// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiExec_h
#define vtkChiExec_h

#include <chiaroscuro/chi.h>

#include "vtkAlgorithm.h"
#include "vtkSMPTools.h"

#include <cstdlib>
#include <string>

// Lends VTK's threads, abort flag and progress bar to the C core for one RequestData() or Render().
class vtkChiExec
{
public:
  // `self` may be null: no abort, no progress (a mapper must not fire events while it draws).
  explicit vtkChiExec(vtkAlgorithm* self)
  {
    this->Exec.struct_size = sizeof(chi_exec);
    this->Exec.user = self;
    this->Exec.parallel_for = &vtkChiExec::ParallelFor;
    if (self)
    {
      this->Exec.is_cancelled = [](void* user) -> int
      { return static_cast<vtkAlgorithm*>(user)->GetAbortExecute(); };
      this->Exec.progress = [](void* user, double fraction)
      { static_cast<vtkAlgorithm*>(user)->UpdateProgress(fraction); };
    }
  }
  vtkChiExec(const vtkChiExec&) = delete;
  void operator=(const vtkChiExec&) = delete;

  const chi_exec* Get() const { return &this->Exec; }

private:
  // Stock VTK starts with the Sequential backend, so that nearly every user would get one core.
  // Where neither the application nor the environment has chosen, borrow STDThread for this call;
  // the application's own choice is left as it is.
  static void ParallelFor(void*, size_t count, chi_range_fn body, void* data)
  {
    const auto loop = [&]()
    {
      vtkSMPTools::For(0, static_cast<vtkIdType>(count),
        [body, data](vtkIdType begin, vtkIdType end)
        { body(data, static_cast<size_t>(begin), static_cast<size_t>(end)); });
    };
    const char* backend = vtkSMPTools::GetBackend();
    if (backend && std::string(backend) == "Sequential" && !std::getenv("VTK_SMP_BACKEND_IN_USE") &&
      !vtkSMPTools::IsParallelScope())
    {
      vtkSMPTools::LocalScope(vtkSMPTools::Config{ 0, "STDThread", false }, loop);
    }
    else
    {
      loop();
    }
  }

  chi_exec Exec = {};
};

#endif
