// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkChiPVFiberSurface
 * @brief   vtkChiFiberSurface with a setter a property
 */
#ifndef vtkChiPVFiberSurface_h
#define vtkChiPVFiberSurface_h

#include "vtkChiFiberSurface.h"
#include "vtkChiParaViewFiltersModule.h" // for export macro

class VTKCHIPARAVIEWFILTERS_EXPORT vtkChiPVFiberSurface : public vtkChiFiberSurface
{
public:
  static vtkChiPVFiberSurface* New();
  vtkTypeMacro(vtkChiPVFiberSurface, vtkChiFiberSurface);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * SetInputArrayToProcess and SetComponent of one array: ParaView's properties pass no index of
   * their own.
   */
  void SelectFirstArray(int index, int port, int connection, int association, const char* name);
  void SelectSecondArray(int index, int port, int connection, int association, const char* name);
  void SetFirstComponent(int component) { this->SetComponent(0, component); }
  void SetSecondComponent(int component) { this->SetComponent(1, component); }
  ///@}

protected:
  vtkChiPVFiberSurface() = default;
  ~vtkChiPVFiberSurface() override = default;

private:
  vtkChiPVFiberSurface(const vtkChiPVFiberSurface&) = delete;
  void operator=(const vtkChiPVFiberSurface&) = delete;
};

#endif
