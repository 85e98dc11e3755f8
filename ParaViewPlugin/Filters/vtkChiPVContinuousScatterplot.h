// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkChiPVContinuousScatterplot
 * @brief   vtkChiContinuousScatterplot with a setter a property
 *
 * ParaView's properties set one thing each, without an index, and always name an array. Masses and
 * counts of a plot are field data of both outputs.
 */
#ifndef vtkChiPVContinuousScatterplot_h
#define vtkChiPVContinuousScatterplot_h

#include "vtkChiContinuousScatterplot.h"
#include "vtkChiParaViewFiltersModule.h" // for export macro

#include <string> // for the weight's name

class VTKCHIPARAVIEWFILTERS_EXPORT vtkChiPVContinuousScatterplot
  : public vtkChiContinuousScatterplot
{
public:
  static vtkChiPVContinuousScatterplot* New();
  vtkTypeMacro(vtkChiPVContinuousScatterplot, vtkChiContinuousScatterplot);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * SetComponent and SetRange of one array.
   */
  void SetFirstComponent(int component) { this->SetComponent(0, component); }
  void SetSecondComponent(int component) { this->SetComponent(1, component); }
  void SetWeightComponent(int component) { this->SetComponent(2, component); }
  void SetFirstRange(double low, double high) { this->SetRange(0, low, high); }
  void SetSecondRange(double low, double high) { this->SetRange(1, low, high); }
  ///@}

  ///@{
  /**
   * SetInputArrayToProcess(0, ...) and (1, ...), whatever the index.
   */
  void SelectFirstArray(int index, int port, int connection, int association, const char* name);
  void SelectSecondArray(int index, int port, int connection, int association, const char* name);
  ///@}

  ///@{
  /**
   * The weight, as SetInputArrayToProcess(2, ...) has it, and whether it is used. Default off.
   */
  void SelectWeightArray(int index, int port, int connection, int association, const char* name);
  void SetUseWeight(bool on);
  vtkGetMacro(UseWeight, bool);
  ///@}

protected:
  vtkChiPVContinuousScatterplot() = default;
  ~vtkChiPVContinuousScatterplot() override = default;

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkChiPVContinuousScatterplot(const vtkChiPVContinuousScatterplot&) = delete;
  void operator=(const vtkChiPVContinuousScatterplot&) = delete;

  void ApplyWeight();

  bool UseWeight = false;
  int WeightAssociation = 0;
  std::string WeightName;
};

#endif
